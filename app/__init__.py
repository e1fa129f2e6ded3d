"""What does the clinician see and keep?"""
